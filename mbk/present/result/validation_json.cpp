#include "mbk/model/trial/validation_table.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;

void describe(Fields<ChartAxis>& fields) {
  fields.type("ValidationAxis");
  fields.add("label", &ChartAxis::label);
  fields.add("unit", &ChartAxis::unit);
}

void describe(Fields<ChartSeries>& fields) {
  fields.type("ValidationSeries");
  fields.add("name", &ChartSeries::name);
  fields.add("x", &ChartSeries::x);
  fields.add("y", &ChartSeries::y);
  fields.add_unless_empty("intervals", &ChartSeries::intervals, "of y, one for each point");
}

void describe(Fields<Chart>& fields) {
  fields.type("ValidationChart");
  fields.add("title", &Chart::title);
  fields.add("x", &Chart::x);
  fields.add("y", &Chart::y);
  fields.add("series", &Chart::series);
  fields.add_unless_empty("horizontal", &Chart::horizontal);
  fields.add_unless_empty("vertical", &Chart::vertical);
  fields.add_if(&Chart::identity, "identity", &Chart::identity, "identity line");
  fields.add_unless_empty("notes", &Chart::notes);
}

void describe(Fields<ValidationRow>& fields) {
  fields.type("ValidationRow");
  fields.add("what", &ValidationRow::what);
  fields.add("value", &ValidationRow::value);
  fields.add_or_null("interval95", &ValidationRow::interval95,
                     "two-sided interval of the value, from the number of runs; an infinite end is null; null: the "
                     "value is not an estimate and is judged without interval");
  fields.add_or_null("expected", &ValidationRow::expected,
                     "accepted range, with its ends; null: the row is informative");
  fields.add("verdict", &ValidationRow::verdict,
             "met: interval95 lies inside expected; falls short: the value lies outside; not shown: the value lies "
             "inside but interval95 does not, or the number of trials is too small for any share to lie inside");
  fields.add_or_null(
      "met", [](const ValidationRow& row) { return row.judged() ? std::optional(row.met()) : std::nullopt; },
      "whether the verdict is met; null: informative");
  fields.add("unit", &ValidationRow::unit);
  fields.add("spread", &ValidationRow::spread, "standard deviation over the runs");
  fields.add("trials", &ValidationRow::trials, "number of trials if the value is a share [%]");
}

void describe(Fields<ValidationTable>& fields) {
  fields.type("Validation", "Output of `mbk validate --json`: a method tested against known truth.");
  fields.header("mbk.validation/2");
  fields.add("study", &ValidationTable::study);
  fields.add("question", &ValidationTable::question);
  fields.add("unit", &ValidationTable::unit, "of rows without their own unit");
  fields.add("runs", &ValidationTable::runs);
  fields.add("seed", &ValidationTable::seed);
  fields.add("rows", &ValidationTable::rows);
  fields.add(
      "verdict", &ValidationTable::verdict,
      "falls short if any row does; otherwise not shown if any row is not shown or none is judged; otherwise met");
  fields.add("met", &ValidationTable::met, "every judged row is met, and at least one is judged");
  fields.add_unless_empty("notes", &ValidationTable::notes);
  fields.add_unless_empty("charts", &ValidationTable::charts);
}

namespace result {

std::string to_json(const ValidationTable& table) {
  return document::document(table);
}

void add_validation_schema(document::Schemas& schemas) {
  schemas["validation"] = document::schema_of<ValidationTable>();
}

}  // namespace result
}  // namespace mbk
