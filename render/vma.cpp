// The one place where the Vulkan Memory Allocator is compiled.
#define VMA_IMPLEMENTATION
#include "render/vma.h"
