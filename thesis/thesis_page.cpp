#include "thesis/thesis_page.h"

#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/html.h"
#include "mbk/present/result/reproduction_json.h"

#ifdef MBK_WEB
extern "C" const char kReproductionPageBegin[], kReproductionPageEnd[];  // page.S
#endif

namespace mbk::thesis {
namespace {

std::string_view page_template() {
#ifdef MBK_WEB
  return {kReproductionPageBegin, static_cast<std::size_t>(kReproductionPageEnd - kReproductionPageBegin)};
#else
  return {};
#endif
}

}  // namespace

Result<std::string> page(const Reproduction& reproduction) {
  result::Drawings drawings;
  for (const Exhibit& exhibit : reproduction.exhibits) {
    for (const Chart& chart : exhibit.charts) drawings[exhibit.id].push_back(report::chart_svg(chart));
  }
  return report::filled_page(page_template(), result::page_json(reproduction, drawings));
}

}  // namespace mbk::thesis
