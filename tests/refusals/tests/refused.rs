//! Programs that must not compile, each with what the compiler says (`refused/*.stderr`).

#[test]
fn unsafe_programs_do_not_compile() {
    trybuild::TestCases::new().compile_fail("refused/*.rs");
}
