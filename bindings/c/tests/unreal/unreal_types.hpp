// The few types of Unreal that the page's component uses, as far as they are needed to run it without Unreal.
#ifndef UNREAL_TYPES_HPP
#define UNREAL_TYPES_HPP
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <set>
#include <vector>

#define UCLASS(...)
#define GENERATED_BODY()
#define TEXT(words) words
#define UTF8_TO_TCHAR(words) words
#define UE_LOG(category, level, ...) (std::printf(__VA_ARGS__), std::printf("\n"), warnings++)

static int warnings;
using int32 = std::int32_t;
using uint32 = std::uint32_t;

struct FVector {
    double X, Y, Z;
    double Size() const { return std::sqrt(X * X + Y * Y + Z * Z); }
};
struct FVector2D {
    double X, Y;
};
template <typename T> class TArray {
public:
    void SetNumZeroed(int32 count) { all.assign(static_cast<std::size_t>(count), T()); }
    void SetNum(int32 count) { all.resize(static_cast<std::size_t>(count)); }
    int32 Num() const { return static_cast<int32>(all.size()); }
    T *GetData() { return all.data(); }

private:
    std::vector<T> all;
};
template <typename T> class TSet {
public:
    bool Contains(const T &one) const { return all.count(one) > 0; }
    void Add(const T &one) { all.insert(one); }
    int32 Remove(const T &one) { return static_cast<int32>(all.erase(one)); }

private:
    std::set<T> all;
};
struct UWorld {
    double Seconds = 0.0;
    double GetTimeSeconds() const { return Seconds; }
};
class USynthComponent {
public:
    virtual ~USynthComponent() = default;
    UWorld *GetWorld() const { return World; }
    // What the engine calls.
    bool Starts(int32 rate) { return Init(rate); }
    int32 Generates(float *out, int32 samples) { return OnGenerateAudio(out, samples); }
    UWorld *World = nullptr;

protected:
    virtual bool Init(int32 &) { return false; }
    virtual int32 OnGenerateAudio(float *, int32) { return 0; }
    int32 NumChannels = 1;
};
#endif
