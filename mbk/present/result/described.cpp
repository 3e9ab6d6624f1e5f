#include "mbk/present/result/described.h"

namespace mbk {

using document::Fields;

void describe(Fields<Warning>& fields) {
  fields.type("Warning", "Why an answer needs care.");
  fields.add("code", &Warning::code);
  fields.add("message", &Warning::message, "what was found");
  fields.add("try", &Warning::remedy, "what to do");
  const auto former = [](const Warning& warning) {
    return std::string(warning.was.empty() ? former_word_of(warning.code) : warning.was);
  };
  fields.add_if([former](const Warning& warning) { return !former(warning).empty(); }, "was", former,
                "the code until the version before, where it changed");
}

void describe(Fields<SourceFile>& fields) {
  fields.type("Input", "A file that was read.");
  fields.add("file", &SourceFile::path, "path, as it was given");
  fields.add("sha256", &SourceFile::sha256, "of the file's bytes, in hexadecimal; empty where it was not a file");
  fields.add("format", &SourceFile::format, "\"CSV\", \"MAT level 5\"; empty where it is not known");
  fields.add_if([](const SourceFile& source) { return !source.trial.empty(); }, "trial", &SourceFile::trial,
                "which of the trials that the file holds; absent where it holds one");
}

}  // namespace mbk
