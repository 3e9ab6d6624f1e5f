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
  fields.add_if(&Chart::identity, "identity", &Chart::identity, "a line where both axes agree");
  fields.add_unless_empty("notes", &Chart::notes);
}

void describe(Fields<ValidationRow>& fields) {
  fields.type("ValidationRow");
  fields.add("what", &ValidationRow::what);
  fields.add("value", &ValidationRow::value);
  fields.add_or_null("interval95", &ValidationRow::interval95,
                     "of the value, two-sided, from the number of runs, an end null where it is infinite; null: the "
                     "value is no estimate, and is judged as it stands");
  fields.add_or_null("expected", &ValidationRow::expected,
                     "accepted range, with its ends; null: the row is informative");
  fields.add("verdict", &ValidationRow::verdict,
             "met: interval95 lies inside expected; falls short: the value lies outside; not shown: the value lies "
             "inside and interval95 does not, or no share of so few trials could lie inside");
  fields.add_or_null(
      "met", [](const ValidationRow& row) { return row.judged() ? std::optional(row.met()) : std::nullopt; },
      "whether the verdict is met; null: informative");
  fields.add("unit", &ValidationRow::unit);
  fields.add("spread", &ValidationRow::spread, "standard deviation over the runs");
  fields.add("trials", &ValidationRow::trials, "the value is a share [%] of so many");
}

void describe(Fields<ValidationTable>& fields) {
  fields.type("Validation", "What `mbk validate --json` writes: a method against known truth.");
  fields.header("mbk.validation/2");
  fields.add("study", &ValidationTable::study);
  fields.add("question", &ValidationTable::question);
  fields.add("unit", &ValidationTable::unit, "of the rows that name none");
  fields.add("runs", &ValidationTable::runs);
  fields.add("seed", &ValidationTable::seed);
  fields.add("rows", &ValidationTable::rows);
  fields.add("verdict", &ValidationTable::verdict,
             "falls short where a row does, else not shown where a row is or none is judged, else met");
  fields.add("met", &ValidationTable::met, "every row that is judged, and one is");
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
