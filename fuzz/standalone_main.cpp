// A fuzz target without libFuzzer: changes the seeds at random, identically in every run, without coverage guidance.
//   PROGRAM RUNS [SEED]      number of inputs; exit 0 if all of them pass
//   PROGRAM --input FILE     one input, to reproduce a finding

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kLongest = 16384;
constexpr const char* kFinding = "finding.bin";

std::string input;  // the current input; the handler below saves it

void keep_input(int signal) {
  if (std::FILE* file = std::fopen(kFinding, "wb")) {
    std::fwrite(input.data(), 1, input.size(), file);
    std::fclose(file);
  }
  constexpr std::string_view kText = "a finding; the input is in finding.bin: pass --input finding.bin\n";
  if (::write(STDERR_FILENO, kText.data(), kText.size()) < 0) std::_Exit(2);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, unsigned seed) : seeds_(std::move(seeds)), random_(seed) {}

  std::string next() {
    std::string text = any_seed();
    for (std::size_t changes = 1 + below(5); changes > 0; --changes) change(text);
    text.resize(std::min(text.size(), kLongest));
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  const std::string& any_seed() { return seeds_[below(seeds_.size())]; }

  void change(std::string& text) {
    constexpr unsigned char kEdges[] = {0x00, 0x01, 0x7F, 0x80, 0xFF, '\n', ',', '"', '=', '[', '{', '-', '9'};
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(text.size() - at, 32) + 1);
    switch (below(8)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random_());
        break;
      case 1:
        if (at < text.size()) text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1u << below(8)));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(kEdges[below(std::size(kEdges))]);
        break;
      case 3:
        text.insert(at, 1 + below(8), static_cast<char>(kEdges[below(std::size(kEdges))]));
        break;
      case 4:
        text.erase(at, length);
        break;
      case 5:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      case 6:
        text.resize(at);
        break;
      default: {
        const std::string& other = any_seed();
        const std::size_t from = below(other.size() + 1);
        text.replace(at, length, other, from, below(64));
      }
    }
  }

  std::vector<std::string> seeds_;
  std::mt19937 random_;
};

void try_input() {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

}  // namespace

int main(int count, char** arguments) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, keep_input);
  if (count == 3 && std::string_view(arguments[1]) == "--input") {
    std::ifstream file(arguments[2], std::ios::binary);
    if (!file) return std::fprintf(stderr, "cannot read %s\n", arguments[2]), 2;
    input.assign(std::istreambuf_iterator<char>(file), {});
    try_input();
    return 0;
  }
  const long runs = count > 1 ? std::strtol(arguments[1], nullptr, 10) : 0;
  if (runs <= 0) return std::fputs("usage: PROGRAM RUNS [SEED]   or   PROGRAM --input FILE\n", stderr), 2;
  const unsigned seed = count > 2 ? static_cast<unsigned>(std::strtoul(arguments[2], nullptr, 10)) : 1;

  const std::vector<std::string> seeds = mbk::fuzz::seeds();
  for (const std::string& one : seeds) {
    input = one;
    try_input();
  }
  Mutator mutator(seeds, seed);
  for (long i = 0; i < runs; ++i) {
    input = mutator.next();
    try_input();
  }
  std::printf("%ld inputs from %zu seeds passed\n", runs, seeds.size());
  return 0;
}
