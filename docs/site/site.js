/* Search shows parts of the pages that it finds, which a browser reads only from a server. */
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;

/* What is wider than its place is scrolled by keyboard too. */
function letScroll() {
  for (const one of document.querySelectorAll("article pre, article .formula, article .table-wrapper")) {
    if (one.scrollWidth > one.clientWidth) one.tabIndex = 0;
    else one.removeAttribute("tabindex");
  }
}
addEventListener("DOMContentLoaded", letScroll);
addEventListener("resize", letScroll);

/* Plays the recording of the first commands, where the player is and nobody asked for less motion; else its text stands. */
function playRecording() {
  const place = document.querySelector(".terminal");
  if (!place || !window.AsciinemaPlayer || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const player = AsciinemaPlayer.create({ data: document.getElementById("first-commands").textContent.trim() }, place, {
    poster: place.dataset.poster,
    fit: "width",
    theme: "asciinema",
    terminalFontFamily: "ui-monospace, 'DejaVu Sans Mono', 'Noto Sans Mono', monospace",
  });
  /* By keyboard: space plays, arrows seek. */
  player.el.tabIndex = 0;
  player.el.setAttribute("role", "application");
  player.el.setAttribute("aria-label", "Recording of a terminal: space plays and pauses. The same follows as text.");
  document.querySelector(".recorded").open = false;
}
addEventListener("DOMContentLoaded", playRecording);
