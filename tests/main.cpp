// Entry point of test programs: `gnomon_tests "[7.18.8]"` runs the tests of a specification section.
#include "tests/session.h"

int main(int argc, char** argv) { return gnomon::run_session(argc, argv); }
