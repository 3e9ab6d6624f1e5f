// Hands the chunks of a job out to the ranks of a run of MPI. Each rank but the first does its chunks as processes of
// their own, so that one that crashes costs its chunk and not the run.
//   mpirun -n RANKS mbk_mpi LIST COMMAND…     LIST: the chunks, one a line; each is done by COMMAND… --chunk K
#include <mpi.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr int kAsk = 1, kGive = 2;  // tags of messages
constexpr long kNothing = -1;       // the answer where no chunk is left, and what a rank did before its first

/// Waits for a message without keeping a core busy, as MPI_Recv would.
MPI_Status receive(long& value, int from, int tag) {
  for (int there = 0; there == 0;) {
    MPI_Iprobe(from, tag, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    if (there == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  MPI_Status status;
  MPI_Recv(&value, 1, MPI_LONG, from, tag, MPI_COMM_WORLD, &status);
  return status;
}

/// @returns  how many chunks were done in vain
int hand_out(const char* list, int ranks) {
  std::ifstream stream(list);
  std::vector<long> chunks;
  for (long chunk = 0; stream >> chunk;) chunks.push_back(chunk);
  std::size_t next = 0;
  int failed = 0;
  for (int working = ranks - 1; working > 0;) {
    long code = 0;
    const MPI_Status status = receive(code, MPI_ANY_SOURCE, kAsk);
    if (code != kNothing && code != 0) ++failed;
    const bool left = next < chunks.size();
    const long chunk = left ? chunks[next++] : kNothing;
    if (!left) --working;
    MPI_Send(&chunk, 1, MPI_LONG, status.MPI_SOURCE, kGive, MPI_COMM_WORLD);
  }
  return failed;
}

/// What a chunk's process ended with; it ends with this one, whatever ends it.
long perform(const std::vector<std::string>& command, long chunk) {
  std::vector<std::string> words = command;
  words.insert(words.end(), {"--with-parent", "--chunk", std::to_string(chunk)});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t id = -1;
  const int error = posix_spawnp(&id, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (error != 0) return error;
  int status = 0;
  while (waitpid(id, &status, 0) < 0) {
    if (errno != EINTR) return errno;
  }
  return status;
}

void work(const std::vector<std::string>& command) {
  long code = kNothing, chunk = 0;
  while (true) {
    MPI_Send(&code, 1, MPI_LONG, 0, kAsk, MPI_COMM_WORLD);
    receive(chunk, 0, kGive);
    if (chunk == kNothing) return;
    code = perform(command, chunk);
  }
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0, ranks = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  int code = 0;
  if (argc < 3 || ranks < 2) {
    if (rank == 0) std::fputs("mpirun -n RANKS mbk_mpi LIST COMMAND…, with two ranks or more\n", stderr);
    code = 2;
  } else if (rank == 0) {
    code = hand_out(argv[1], ranks) > 0 ? 3 : 0;
  } else {
    work({argv + 2, argv + argc});
  }
  MPI_Finalize();
  return code;
}
