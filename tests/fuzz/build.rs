//! Compiles the C program of random calls with the fuzzer's bytes as its dice.

fn main() {
    let c = "../../bindings/c";
    println!("cargo:rerun-if-changed={c}/tests/fuzz.c");
    cc::Build::new()
        .file(format!("{c}/tests/fuzz.c"))
        .include(c)
        .define("BYTES_OF_A_FUZZER", None)
        .flag("-O1")
        .compile("asperity_calls");
}
