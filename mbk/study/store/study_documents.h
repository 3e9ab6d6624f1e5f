#pragma once

#include "mbk/base/document/fields.h"
#include "mbk/study/store/study_list.h"

/// Descriptions of what several documents of a study hold. For the sources of this project only.
namespace mbk::store {

/// How many recordings of a study are in which state.
struct Counts {
  const StudyList& of;
};

void describe(document::Fields<Analysis>& fields);
void describe(document::Fields<StoredRecording>& fields);
void describe(document::Fields<ListedRecording>& fields);
void describe(document::Fields<Counts>& fields);

/// Adds the schemas of what list, show, log, check and export write.
void add_schemas(document::Schemas& schemas);

}  // namespace mbk::store
