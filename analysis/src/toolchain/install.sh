# Installs packages of Debian as root, without removing one: install.sh FOLDER PACKAGE...
# Where that would remove another package, the emulator is unpacked into the folder instead: qemu-utils of a
# later Debian excludes it. Other packages look for their parts where they are installed.
set -eu
exec >&2
export LC_ALL=C DEBIAN_FRONTEND=noninteractive
folder=$1
shift
if [ "$(id -u)" != 0 ] || ! command -v apt-get > /dev/null; then
    echo "set-up: not installed here, only as root on Debian"
    exit 1
fi
get() { apt-get -qq -o DPkg::Lock::Timeout=600 "$@"; }
# A new machine has no lists, and a mirror may have dropped the versions that old lists name. Without a
# network the old lists may be enough.
echo "set-up: apt-get update"
get update || true
changes=$(get install --simulate --no-install-recommends "$@")
new=$(echo "$changes" | sed -n 's/^Inst \([^ ]*\).*/\1/p')
removed=$(echo "$changes" | sed -n -E 's/^(Remv|Purg) ([^ ]*).*/\2/p')
echo "set-up: apt-get install --no-install-recommends $*: installs" $new
if [ -z "$removed" ]; then
    # The machine may have changed since the simulation.
    get install --yes --no-install-recommends --no-remove "$@" > /dev/null
    exit
fi
echo "set-up: not done, because it REMOVES" $removed
[ "$*" = qemu-system-arm ] || exit 1
echo "set-up: unpacks these packages into $folder"
# Renamed at the end, so that an interrupted unpacking does not count.
rm -rf "$folder" "$folder.new"
mkdir -p "$folder.new/archives"
cd "$folder.new/archives"
# Not the C library, whose loader starts every program and is the machine's.
get -o APT::Sandbox::User=root download $(echo "$new" | grep -v '^libc6')
for archive in *.deb; do
    dpkg-deb -x "$archive" ..
done
cd ..
rm -r archives
cat > qemu-system-arm << 'END'
#!/bin/sh
here=$(dirname "$0")
libraries=$(uname -m)-linux-gnu
export LD_LIBRARY_PATH="$here/usr/lib/$libraries:$here/lib/$libraries"
exec "$here/usr/bin/qemu-system-arm" -L "$here/usr/share/qemu" "$@"
END
chmod +x qemu-system-arm
mv "$folder.new" "$folder"
