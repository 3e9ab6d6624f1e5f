#include "mbk/base/core/result.h"

#include <gtest/gtest.h>

#include "mbk/base/core/printable.h"

namespace mbk {
namespace {

TEST(Error, IsOneLineWhateverItQuotes) {
  const Error error = bad_data("'a\nb' is \x01 not \xE9t\xC3\xA9", "try\tthis", "a\rfile").value().in("a\x7f folder");
  EXPECT_EQ(error.line(), "a? folder, a?file: 'a?b' is ? not étÃ©; try?this");
  EXPECT_EQ(bad_usage("'\xFF'").value().line(), "'ÿ'");
}

TEST(Error, NamesPlacesFromTheOutsideIn) {
  const Error error = bad_data("is wrong", "mend it", "line 3").value();
  EXPECT_EQ(error.in("file").line(), "file, line 3: is wrong; mend it");
  EXPECT_EQ(bad_data("is wrong").value().in("file").line(), "file: is wrong");
}

TEST(Error, KeepsItsCodeWhereverItGoes) {
  const Error error = with_code("torn", bad_data("is wrong")).value();
  EXPECT_EQ(error.in("file").code, "torn");
  EXPECT_EQ(bad_data("is wrong").value().code, "");
}

TEST(Printable, IsOneLineAndKeepsUtf8) {
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  EXPECT_EQ(printable("N·m °"), "N·m °");
  EXPECT_EQ(printable("\x80\xB0"), "?°");
}

}  // namespace
}  // namespace mbk
