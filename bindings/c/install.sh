#!/bin/sh
# Builds the library and installs it under PREFIX: headers, shared and static library, pkg-config file, CMake package.
#
#   PREFIX=$HOME/.local ./install.sh [cargo's own flags, for instance --features device]
set -eu
cd "$(dirname "$0")"
prefix="${PREFIX:?name a folder: PREFIX=\$HOME/.local ./install.sh}"
mkdir -p "$prefix"
prefix="$(cd "$prefix" && pwd)"

messages="$(cargo build --release -p asperity-c --message-format json-render-diagnostics "$@")"
built="$(printf '%s\n' "$messages" | grep -o '"filenames":\["[^]]*libasperity_c[^]]*' | tail -1 | grep -o '"[^"]*/libasperity_c\.\(so\|dylib\)"' | tr -d '"')"
static="${built%.*}.a"
version="$(cargo pkgid -p asperity-c | sed 's/.*[#@]//')"
major="${version%%.*}"
case "$built" in
*.dylib) shared="libasperity.$major.dylib" link=libasperity.dylib private="-framework Security -liconv -lm" ;;
*) shared="libasperity.so.$version" link=libasperity.so private="-lpthread -ldl -lm" ;;
esac

install -d "$prefix/include" "$prefix/lib/pkgconfig" "$prefix/lib/cmake/asperity"
install -m 644 asperity.h asperity.hpp asperity_openxr.h "$prefix/include/"
install -m 755 "$built" "$prefix/lib/$shared"
install -m 644 "$static" "$prefix/lib/libasperity.a"
# Names of lines and of local functions, and the compiler's own notes, are four fifths of the files, and tell a program of C nothing.
if command -v strip >/dev/null; then
    chmod u+w "$prefix/lib/$shared" "$prefix/lib/libasperity.a"
    case "$built" in
    *.dylib) strip -S "$prefix/lib/$shared" "$prefix/lib/libasperity.a" ;;
    *) strip --strip-unneeded -R .llvmbc -R .llvmcmd "$prefix/lib/$shared" "$prefix/lib/libasperity.a" ;;
    esac
fi
[ "$link" = libasperity.dylib ] || ln -sf "$shared" "$prefix/lib/libasperity.so.$major"
ln -sf "$shared" "$prefix/lib/$link"

filled() {
    sed -e "s|@VERSION@|$version|; s|@SHARED@|lib/$shared|; s|@STATIC@|lib/libasperity.a|" \
        -e "s|@IMPLIB@||; s|@PRIVATE@|$private|; s|@PRIVATE_CMAKE@|$(printf %s "$private" | tr ' ' ';')|" "$1"
}
filled asperity.pc.in >"$prefix/lib/pkgconfig/asperity.pc"
filled cmake/asperity-config.cmake.in >"$prefix/lib/cmake/asperity/asperity-config.cmake"
filled cmake/asperity-config-version.cmake.in >"$prefix/lib/cmake/asperity/asperity-config-version.cmake"
echo "asperity $version is installed under $prefix"
