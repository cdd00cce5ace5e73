// Tables of the leaderboard sort by the column that is pressed; boxes that scroll can be reached by the keyboard; a link to
// a case opens it.
addEventListener("DOMContentLoaded", () => {
  "use strict";
  const reach = () => {
    for (const box of document.querySelectorAll(".table-wrapper, article pre, div.equation")) {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
    }
  };

  function order(cell) {
    const number = cell.dataset.order;
    return number === undefined ? cell.textContent : number === "inf" ? Infinity : Number(number);
  }

  function compare(a, b) {
    if (typeof a === "string") return a.localeCompare(b, "en", { numeric: true });
    return a === b ? 0 : a - b;
  }

  for (const table of document.querySelectorAll("table.sortable")) {
    const heads = [...table.tHead.rows[0].cells];
    for (const [column, head] of heads.entries()) {
      head.querySelector("button").addEventListener("click", () => {
        const turned = head.getAttribute("aria-sort") === "ascending";
        for (const other of heads) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", turned ? "descending" : "ascending");
        const rows = [...table.tBodies[0].rows];
        rows.sort((a, b) => compare(order(a.cells[column]), order(b.cells[column])) * (turned ? -1 : 1));
        table.tBodies[0].append(...rows);
      });
    }
  }

  function open() {
    const named = location.hash && document.getElementById(location.hash.slice(1));
    if (named && named.tagName === "DETAILS") {
      named.open = true;
      named.scrollIntoView();
    }
  }

  reach();
  addEventListener("resize", reach);
  document.addEventListener("toggle", reach, true);
  addEventListener("hashchange", open);
  open();
});
