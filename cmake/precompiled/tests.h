#pragma once

// The same for tests (cmake/MbkPrecompile.cmake).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "library.h"
