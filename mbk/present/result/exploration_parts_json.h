#pragma once

#include "mbk/model/trial/exploration.h"
#include "mbk/present/result/described.h"

/// Parts of an exploration. For the sources of this module only.
namespace mbk {

void describe(document::Fields<FrequencyResponseEstimate>& fields);
void describe(document::Fields<ImpulseResponseEstimate>& fields);
void describe(document::Fields<ParallelCascadeEstimate>& fields);
void describe(document::Fields<PlateauStiffness>& fields);
void describe(document::Fields<ReachStiffness>& fields);
void describe(document::Fields<TimeCourseEstimate>& fields);
void describe(document::Fields<AfterOnsetEstimate>& fields);
void describe(document::Fields<EmgEstimate>& fields);
void describe(document::Fields<StretchEstimate>& fields);

}  // namespace mbk
