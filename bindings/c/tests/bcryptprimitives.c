/* The one function of bcryptprimitives.dll that Rust's standard library calls, for Wine before 8.1, which has no such file. */
#include <windows.h>
#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE data, SIZE_T length) { return RtlGenRandom(data, (ULONG)length); }
