#include "apps/mbk/caller.h"

#include <algorithm>
#include <utility>

namespace mbk::app {
namespace {

/// The index of the input that `word` refers to; `count` if there is none.
std::size_t place_of(const std::filesystem::path& word, std::size_t count, std::string (*word_of)(std::size_t)) {
  const std::string text = word.string();
  std::size_t k = 0;
  while (k < count && text != word_of(k)) ++k;
  return k;
}

}  // namespace

Caller* Caller::current() noexcept {
  return dynamic_cast<Caller*>(Requester::current());
}

bool Caller::stopped() {
  if (!stopped_ && call_.stop && call_.stop()) stopped_ = true;
  return stopped_;
}

void Caller::say(std::string_view text) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  const std::scoped_lock lock(mutex_);
  messages_.emplace_back(text);
}

void Caller::write(std::string_view text) {
  const std::scoped_lock lock(mutex_);
  output_ += text;
  wrote_ = true;
}

void Caller::fail(const Error& error) {
  const std::scoped_lock lock(mutex_);
  errors_.push_back(error);
}

void Caller::reached(std::string_view what, double fraction) {
  if (stopped()) throw Stopped();
  if (!call_.progress) return;
  const std::scoped_lock lock(mutex_);
  call_.progress(what, fraction);
}

std::shared_ptr<const recording::InMemory> Caller::recording(const std::filesystem::path& word) const {
  const std::size_t k = place_of(word, call_.recordings.size(), recording_word);
  return k < call_.recordings.size() ? call_.recordings[k] : nullptr;
}

const std::string* Caller::document(const std::filesystem::path& word) const {
  const std::size_t k = place_of(word, call_.documents.size(), document_word);
  return k < call_.documents.size() ? &call_.documents[k] : nullptr;
}

Answer Caller::take(int exit_code, bool& wrote) {
  const std::scoped_lock lock(mutex_);
  wrote = wrote_;
  return {std::move(output_), false, exit_code, std::move(errors_), std::move(messages_)};
}

}  // namespace mbk::app
