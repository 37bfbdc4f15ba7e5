// Only in builds with AddressSanitizer: libraries that are loaded stay loaded, so that a leak inside one still has a
// name when the process ends and lsan.supp can tell theirs from ours.
extern "C" int dlclose(void*) { return 0; }
