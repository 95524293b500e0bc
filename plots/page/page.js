// Sorts tables by a click on a head, and switches between light and dark. The page is whole without it.
(function () {
  "use strict";
  const root = document.documentElement;
  root.classList.add("scripted");

  const UNITS = { "µs": 1e-6, ms: 1e-3, s: 1, min: 60, h: 3600, d: 86400, mm: 1e-3, cm: 1e-2, m: 1, km: 1e3, kB: 1e3, MB: 1e6, GB: 1e9 };
  const RAISED = { "⁻": "-", "⁰": "0", "¹": "1", "²": "2", "³": "3", "⁴": "4", "⁵": "5", "⁶": "6", "⁷": "7", "⁸": "8", "⁹": "9" };

  /** The number that a cell begins with, in the base of its unit; none if it begins with a word. */
  function numberOf(text) {
    const plain = text.replace(/−/g, "-").replace(/^(at most|perhaps|within)\s+/, "");
    const found = /^\s*([+-]?[\d.]+(?:e[+-]?\d+)?)(?:\s*·\s*10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?\s*([^\s\d]*)/.exec(plain);
    if (!found) return null;
    const power = found[2] ? Number([...found[2]].map((sign) => RAISED[sign]).join("")) : 0;
    return Number(found[1]) * 10 ** power * (UNITS[found[3]] || 1);
  }

  function compare(a, b) {
    const [x, y] = [numberOf(a), numberOf(b)];
    if (x !== null && y !== null) return x - y;
    if (x !== null) return -1;
    if (y !== null) return 1;
    return a.localeCompare(b);
  }

  function sortBy(head) {
    const body = head.closest("table").tBodies[0];
    const down = head.getAttribute("aria-sort") === "ascending";
    for (const other of head.parentElement.children) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const column = head.cellIndex;
    const cell = (row) => row.cells[column].textContent;
    const rows = [...body.rows];
    rows.sort((a, b) => {
      // What says nothing stays below, either way.
      if (!cell(a) !== !cell(b)) return cell(a) ? -1 : 1;
      return down ? compare(cell(b), cell(a)) : compare(cell(a), cell(b));
    });
    body.append(...rows);
  }

  for (const head of document.querySelectorAll("thead th")) {
    head.tabIndex = 0;
    head.title = "Sort by this column";
    head.addEventListener("click", () => sortBy(head));
    head.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      sortBy(head);
    });
  }

  const theme = document.getElementById("theme");
  theme.hidden = false;
  theme.addEventListener("click", () => {
    const own = root.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    root.dataset.theme = own === "dark" ? "light" : "dark";
    document.dispatchEvent(new Event("themechange"));
  });

  // What is folded is printed too.
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...document.querySelectorAll("details:not([open])")];
    for (const details of opened) details.open = true;
  });
  addEventListener("afterprint", () => {
    for (const details of opened) details.open = false;
  });
  // A link to what is folded opens it.
  addEventListener("hashchange", () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const folded = target && target.closest("details");
    if (folded) folded.open = true;
  });
})();
