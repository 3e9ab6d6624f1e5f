#include "apps/mbk/terminal/citation.h"

#include <fmt/format.h>

#include "mbk/base/core/version.h"

namespace mbk::app {

// BibTeX has no entry for software; @misc works with every style.
std::string bibtex() {
  return fmt::format(
      "@misc{{mbk,\n"
      "  author = {{{{The mbk authors}}}},\n"
      "  title  = {{{{mbk}}: mechanical impedance of the human arm, measured with a rehabilitation robot}},\n"
      "  note   = {{Computer software, version {}}},\n"
      "  year   = {{{}}}\n"
      "}}\n\n"
      "@mastersthesis{{Dyck2013,\n"
      "  author = {{Dyck, M.}},\n"
      "  title  = {{Measuring the Dynamic Impedance of the Human Arm}},\n"
      "  school = {{University of Alberta}},\n"
      "  year   = {{2013}}\n"
      "}}",
      version(), release_date().substr(0, 4));
}

}  // namespace mbk::app
