#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <string>

namespace mbk::physics {

template <class Value, void (*free)(Value*)>
struct Free {
  void operator()(Value* value) const { free(value); }
};
using EngineModel = std::unique_ptr<mjModel, Free<mjModel, mj_deleteModel>>;
using EngineData = std::unique_ptr<mjData, Free<mjData, mj_deleteData>>;

/// The engine's model of a world that is described in its own language.
inline EngineModel compiled(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();  // too large for the stack
  mj_defaultVFS(files.get());
  EXPECT_EQ(mj_makeEmptyFileVFS(files.get(), "arm.xml", static_cast<int>(xml.size())), 0);
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[500] = "";
  EngineModel model(mj_loadXML("arm.xml", files.get(), error, sizeof error));
  mj_deleteFileVFS(files.get(), "arm.xml");
  EXPECT_TRUE(model) << error;
  return model;
}

}  // namespace mbk::physics
