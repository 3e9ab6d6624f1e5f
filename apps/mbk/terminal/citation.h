#pragma once

#include <string>

namespace mbk::app {

/// BibTeX entries of this version of mbk and of the thesis that it is based on, as in CITATION.cff.
[[nodiscard]] std::string bibtex();

}  // namespace mbk::app
