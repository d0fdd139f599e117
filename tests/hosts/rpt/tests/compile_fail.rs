//! What rpt lacks is an error of the compiler that says so in a sentence.

#[test]
fn a_missing_capability_is_named() {
    trybuild::TestCases::new().compile_fail("tests/compile_fail/*.rs");
}
