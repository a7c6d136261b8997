// Light or dark: as the system has it, until the button says otherwise.

/** Where the browser keeps what was chosen. */
const THEME_KEY = "haptic-theme";

/** The button that changes from light to dark and back. */
function themeButton() {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ?? (system.matches ? "dark" : "light")) === "dark";
  const button = make("button", { type: "button", id: "theme", textContent: "Dark" });
  const show = () => {
    button.ariaPressed = String(isDark());
    dispatchEvent(new Event("themechange"));
  };
  const kept = keptTheme();
  if (kept) root.dataset.theme = kept;
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    try {
      localStorage.setItem(THEME_KEY, root.dataset.theme);
    } catch {
      // A page from a file may have no storage: the choice then lasts as long as the page.
    }
    show();
  });
  system.addEventListener("change", show);
  show();
  return button;
}

function keptTheme() {
  try {
    const kept = localStorage.getItem(THEME_KEY);
    return kept === "light" || kept === "dark" ? kept : undefined;
  } catch {
    return undefined;
  }
}
