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
