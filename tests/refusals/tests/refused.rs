//! Programs that must not compile, each with what the compiler says (`refused/*.stderr`). Their
//! neighbours that must are this package's examples, which are built with its tests.

#[test]
fn unsafe_programs_do_not_compile() {
    trybuild::TestCases::new().compile_fail("refused/*.rs");
}
