#pragma once

// The same for the command line (cmake/MbkPrecompile.cmake).
#include <CLI/CLI.hpp>

#include "library.h"
