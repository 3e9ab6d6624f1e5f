// Holds the precompiled headers of programs (cmake/MbkPrecompile.cmake); it does nothing.
int main() {
  return 0;
}
