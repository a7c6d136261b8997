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
    text: String,
    numbers: Vec<f64>,
}

impl Answers {
    /// Address of the text.
    pub fn text(&self) -> *const u8 {
        self.text.as_ptr()
    }

    /// Its bytes.
    pub fn text_bytes(&self) -> usize {
        self.text.len()
    }

    /// Address of the numbers.
    pub fn numbers(&self) -> *const f64 {
        self.numbers.as_ptr()
    }

    /// Number of the numbers.
    pub fn numbers_count(&self) -> usize {
        self.numbers.len()
    }
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
