// Entry point of gnomon_tests: `gnomon_tests "[7.18.8]"` runs the tests of a specification section.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
