//! The memory shared by page and module: the text of a request, and the text and the numbers of the last
//! answer.

use std::cell::RefCell;

use crate::PageResult;

thread_local! {
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWERS: RefCell<Answers> =
        const { RefCell::new(Answers { text: String::new(), numbers: Vec::new() }) };
}

/// The last answer.
#[derive(Debug, Default)]
pub struct Answers {
    /// Its text.
    pub text: String,
    /// Its numbers.
    pub numbers: Vec<f64>,
}

/// Address for a request with this size in bytes.
pub fn input(bytes: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(bytes, 0);
        input.as_mut_ptr()
    })
}

/// Reads the last answer.
pub fn read<T>(of: impl FnOnce(&Answers) -> T) -> T {
    ANSWERS.with_borrow(of)
}

/// Answers the request: 0, or 1 if the text is a refusal.
pub fn answer(function: impl FnOnce(&str, &mut Vec<f64>) -> PageResult) -> u32 {
    let mut numbers = ANSWERS.with_borrow_mut(|answers| std::mem::take(&mut answers.numbers));
    numbers.clear();
    let question = INPUT.take();
    let answer = match std::str::from_utf8(&question) {
        Ok(question) => function(question, &mut numbers),
        Err(error) => Err(format!("the text is not UTF-8: {error}")),
    };
    let status = u32::from(answer.is_err());
    let text = answer.unwrap_or_else(|refusal| refusal);
    ANSWERS.set(Answers { text, numbers });
    status
}
