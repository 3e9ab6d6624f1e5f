// Holds the precompiled headers of the libraries (cmake/MbkPrecompile.cmake); it has nothing of its own.
