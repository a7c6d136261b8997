//! Where a board is: a serial port, or the socket of an emulated one.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use haptic_servo::board::BAUD;

/// Where a board is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// A serial port.
    Serial {
        /// Name of the port, as the system has it.
        port: String,
        /// Speed in bit/s.
        baud: u32,
    },
    /// A socket on the network.
    Tcp(String),
    /// A socket of this machine.
    Unix(PathBuf),
}

const EMPTY: &str = "the port is empty: name a serial port such as /dev/ttyACM0 or COM3, \
                     tcp://HOST:PORT, or unix:PATH";

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(path) = text.strip_prefix("unix:") {
            // The double slash of a URL, or none.
            let path = path.strip_prefix("//").unwrap_or(path);
            return if path.is_empty() { Err(EMPTY.into()) } else { Ok(Self::Unix(path.into())) };
        }
        if let Some(address) = text.strip_prefix("tcp://") {
            let is_port = |port: &str| port.parse::<u16>().is_ok_and(|port| port > 0);
            return match address.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && is_port(port) => {
                    Ok(Self::Tcp(address.to_owned()))
                }
                _ => Err(format!(
                    "`{text}` is not a valid network address: expected tcp://HOST:PORT, with a port from 1 \
                     to 65535"
                )),
            };
        }
        let (port, baud) = match text.split_once('@') {
            Some((port, baud)) => match baud.parse() {
                Ok(baud) if baud > 0 => (port, baud),
                _ => {
                    return Err(format!(
                        "`{baud}` is not a valid speed: expected a whole number of bit/s, as in \
                         /dev/ttyACM0@{BAUD}"
                    ));
                }
            },
            None => (text, BAUD),
        };
        if port.is_empty() {
            return Err(EMPTY.into());
        }
        Ok(Self::Serial { port: port.to_owned(), baud })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { port, baud } if *baud == BAUD => f.write_str(port),
            Self::Serial { port, baud } => write!(f, "{port}@{baud}"),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_address_reads_as_it_is_written() {
        for text in
            ["/dev/ttyACM0", "COM3", "/dev/ttyUSB1@115200", "tcp://[::1]:4000", "unix:/tmp/b"]
        {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), text);
        }
        assert_eq!("unix:///tmp/b".parse(), Ok(Address::Unix("/tmp/b".into())));
        let serial = Address::Serial { port: "COM3".into(), baud: BAUD };
        assert_eq!("COM3".parse(), Ok(serial));
    }

    #[test]
    fn what_is_no_address_is_said() {
        for (texts, said) in [
            (&["", "unix:", "@9600"][..], "the port is empty"),
            (
                &["tcp://", "tcp://host", "tcp://:80", "tcp://host:0", "tcp://host:port"],
                "is not a valid network address",
            ),
            (&["COM3@", "COM3@fast", "COM3@0"], "is not a valid speed"),
        ] {
            for text in texts {
                assert!(text.parse::<Address>().unwrap_err().contains(said), "{text}");
            }
        }
    }
}
