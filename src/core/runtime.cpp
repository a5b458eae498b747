// Functions that a compiler may call by itself: nothing is linked against.
#include "types.hpp"

#define RW_HIDDEN extern "C" __attribute__((used, visibility("hidden")))

RW_HIDDEN void* memset(void* target, int value, Size count) {
    for (Size i = 0; i < count; i++) static_cast<volatile char*>(target)[i] = static_cast<char>(value);
    return target;
}

RW_HIDDEN void* memcpy(void* target, const void* source, Size count) {
    for (Size i = 0; i < count; i++) static_cast<volatile char*>(target)[i] = static_cast<const char*>(source)[i];
    return target;
}

RW_HIDDEN void* memmove(void* target, const void* source, Size count) {
    if (target <= source) return memcpy(target, source, count);
    for (Size i = count; i-- > 0;) static_cast<volatile char*>(target)[i] = static_cast<const char*>(source)[i];
    return target;
}

#if defined(_WIN32)
extern "C" __attribute__((used)) int DllMainCRTStartup(void*, unsigned, void*) { return 1; }
#endif
