// Boxes that scroll can be reached by the keyboard.
addEventListener("DOMContentLoaded", () => {
  "use strict";
  for (const box of document.querySelectorAll(".table-wrapper, pre, div.equation")) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
});
