#include "mbk/present/report/html.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::report {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kOpening = R"(<script type="application/json" id="report-data">)";

#ifdef MBK_WEB
TEST(Page, IsOneDocumentWithTheDataInIt) {
  const auto html = page(R"({"schema":"mbk.report/1"})", {});
  ASSERT_TRUE(html) << html.error().line();
  EXPECT_THAT(*html, StartsWith("<!doctype html>"));
  EXPECT_THAT(*html, EndsWith("</html>\n"));
  EXPECT_THAT(*html, HasSubstr(std::string(kOpening) + R"({"schema":"mbk.report/1"}</script>)"));
  EXPECT_THAT(*html, Not(HasSubstr("@MBK_REPORT_DATA@")));
}

TEST(Page, LetsNothingInTheDataEndTheElementThatHoldsThem) {
  const auto html = page(R"({"note":"</script><!--<script>"})", {});
  ASSERT_TRUE(html);
  EXPECT_THAT(*html, HasSubstr(R"({"note":"\u003c/script>\u003c!--\u003cscript>"}</script>)"));
}

TEST(Page, HasTextAndDrawingsForReadersWithoutScripts) {
  Chart chart;
  chart.series = {{"a < b", {0, 1}, {1, 2}, {}, ChartSeries::Drawn::line}};
  const auto html = page(R"({"note":"@MBK_REPORT_TEXT@"})", {"K 46 <N/m> & more", {chart}});
  ASSERT_TRUE(html);
  const std::string plain =
      html->substr(html->find("<noscript>"), html->find("</noscript>") - html->find("<noscript>"));
  EXPECT_THAT(plain, HasSubstr("K 46 &lt;N/m> &amp; more"));
  EXPECT_THAT(plain, HasSubstr("<svg"));
  EXPECT_THAT(plain, Not(HasSubstr("a < b")));
  EXPECT_THAT(*html, HasSubstr(R"({"note":"@MBK_REPORT_TEXT@"}</script>)")) << "data stay as they are";
}

TEST(Page, NamesNoFileThatABrowserWouldFetch) {
  const auto html = page("{}", {});
  ASSERT_TRUE(html);
  for (const char* address : {"src=\"", "src='", "href=\"http", "href=\"/", "@import", "url(http"}) {
    EXPECT_THAT(html->substr(0, html->find("<body>")), Not(HasSubstr(address))) << address;
  }
}
#else
TEST(Page, SaysHowToGetItWhereItWasNotBuilt) {
  const auto html = page("{}", {});
  ASSERT_FALSE(html);
  EXPECT_EQ(html.error().kind, ErrorKind::usage);
  EXPECT_THAT(html.error().line(), HasSubstr("-DMBK_WEB=ON"));
}
#endif

}  // namespace
}  // namespace mbk::report
