//! Programs that must not compile, each with what the compiler says (`refused/*.stderr`), and
//! their neighbours that must.

#[test]
fn unsafe_programs_do_not_compile() {
    let programs = trybuild::TestCases::new();
    programs.compile_fail("refused/*.rs");
    programs.pass("accepted/*.rs");
}
