//! The pending and active exceptions, and the next one (ARM DDI 0403E, B1.5).

/// Number of an exception: the core's own below 16, interrupts from there on.
pub type Number = u16;

/// The non-maskable interrupt: a failure of the chip.
pub const NON_MASKABLE: Number = 2;
/// The hard fault: taken if no other exception may take a fault.
pub const HARD_FAULT: Number = 3;
/// The pendable request for service.
pub const PEND_SV: Number = 14;
/// The core's own timer.
pub const SYS_TICK: Number = 15;
/// The first interrupt.
pub const FIRST_INTERRUPT: Number = 16;

/// Interrupts that a chip of these families may have at most.
pub const INTERRUPTS: usize = 112;
const NUMBERS: usize = FIRST_INTERRUPT as usize + INTERRUPTS;

/// Bits of a priority that these chips have, at the top of its byte.
pub const PRIORITY_BITS: u8 = 0xF0;

/// Priority of a program that no exception has interrupted: below all others.
const THREAD: i16 = 256;

/// The core's mask registers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Masks {
    /// PRIMASK: masks all except faults.
    pub primask: bool,
    /// FAULTMASK: masks all except the non-maskable interrupt.
    pub faultmask: bool,
    /// BASEPRI: masks this priority and lower ones; 0 for none.
    pub basepri: u8,
}

impl Masks {
    /// The priority to which they raise the running program.
    fn priority(self) -> i16 {
        let base = if self.basepri == 0 { THREAD } else { i16::from(self.basepri) };
        if self.faultmask {
            -1
        } else if self.primask {
            base.min(0)
        } else {
            base
        }
    }

    /// The same masks without PRIMASK.
    fn without_primask(self) -> Self {
        Self { primask: false, ..self }
    }
}

/// A set of exceptions: a bit each, at the place of its number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Set(u128);

impl Set {
    fn has(self, number: Number) -> bool {
        self.0 & (1 << number) != 0
    }

    fn put(&mut self, number: Number, is_in: bool) {
        self.0 = self.0 & !(1 << number) | u128::from(is_in) << number;
    }

    /// Its numbers, lowest first.
    fn numbers(self) -> impl Iterator<Item = Number> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let number = (left != 0).then(|| left.trailing_zeros() as Number)?;
            left &= left - 1;
            Some(number)
        })
    }
}

/// The controller of exceptions.
#[derive(Clone, Debug)]
pub struct Exceptions {
    enabled: Set,
    /// Requested, by an edge or by the program.
    pending: Set,
    /// Active lines from peripherals, which request their interrupts as long as they are active.
    lines: Set,
    active: Set,
    priorities: [u8; NUMBERS],
    /// Active exceptions, the latest last.
    nested: Vec<Number>,
}

impl Default for Exceptions {
    fn default() -> Self {
        Self {
            // Interrupts have to be enabled; the core's own exceptions that are here cannot be.
            enabled: Set((1 << FIRST_INTERRUPT) - 1),
            pending: Set::default(),
            lines: Set::default(),
            active: Set::default(),
            priorities: [0; NUMBERS],
            nested: Vec::new(),
        }
    }
}

impl Exceptions {
    /// The active exception; `None` in an uninterrupted program.
    pub fn current(&self) -> Option<Number> {
        self.nested.last().copied()
    }

    /// The number of active exceptions.
    pub fn depth(&self) -> usize {
        self.nested.len()
    }

    /// Requests an exception.
    pub fn pend(&mut self, number: Number) {
        self.pending.put(number, true);
    }

    /// Withdraws a request.
    pub fn unpend(&mut self, number: Number) {
        self.pending.put(number, false);
    }

    /// Whether an exception is requested.
    pub fn is_pending(&self, number: Number) -> bool {
        self.asked().has(number)
    }

    /// Whether an exception is active.
    pub fn is_active(&self, number: Number) -> bool {
        self.active.has(number)
    }

    /// Sets a peripheral's line. A requested interrupt stays requested.
    pub fn set_line(&mut self, number: Number, up: bool) {
        // A rising line during service requests the interrupt again.
        if up && !self.lines.has(number) {
            self.pend(number);
        }
        self.lines.put(number, up);
    }

    /// Enables an interrupt or disables it.
    pub fn enable(&mut self, number: Number, enabled: bool) {
        self.enabled.put(number, enabled);
    }

    /// Whether it is enabled.
    pub fn is_enabled(&self, number: Number) -> bool {
        self.enabled.has(number)
    }

    /// Sets its priority, of which the chips have the upper bits. Ignored for an interrupt that the chips do
    /// not have.
    pub fn set_priority(&mut self, number: Number, priority: u8) {
        if let Some(own) = self.priorities.get_mut(usize::from(number)) {
            *own = priority & PRIORITY_BITS;
        }
    }

    /// Its priority as the program reads it.
    pub fn priority(&self, number: Number) -> u8 {
        self.priorities.get(usize::from(number)).copied().unwrap_or(0)
    }

    /// Whether any exception is requested and enabled, masked or not.
    pub fn any_pending(&self) -> bool {
        self.waiting() != Set::default()
    }

    /// The next exception, if it may interrupt the running code.
    pub fn next(&self, masks: Masks) -> Option<Number> {
        let ranked = self.waiting().numbers().map(|number| (self.rank(number), number));
        let (priority, number) = ranked.min()?;
        (priority < self.running(masks)).then_some(number)
    }

    /// Whether an exception would end a wait for interrupts, which PRIMASK does not prevent.
    pub fn wakes(&self, masks: Masks) -> bool {
        self.next(masks.without_primask()).is_some()
    }

    /// Begins to serve an exception.
    pub fn enter(&mut self, number: Number) {
        self.pending.put(number, false);
        self.active.put(number, true);
        self.nested.push(number);
    }

    /// Ends the active exception; a line that is still up requests it again.
    pub fn leave(&mut self) {
        if let Some(number) = self.nested.pop() {
            self.active.put(number, false);
        }
    }

    /// Whether a fault can be served now: not at its own or a higher priority.
    pub fn can_fault(&self, masks: Masks) -> bool {
        self.running(masks) > -1
    }

    /// All requested exceptions.
    fn asked(&self) -> Set {
        Set(self.pending.0 | self.lines.0 & !self.active.0)
    }

    /// All requested and enabled exceptions.
    fn waiting(&self) -> Set {
        Set(self.asked().0 & self.enabled.0)
    }

    /// The priority of the running code.
    fn running(&self, masks: Masks) -> i16 {
        let nested = self.nested.iter().map(|&number| self.rank(number)).min();
        nested.unwrap_or(THREAD).min(masks.priority())
    }

    fn rank(&self, number: Number) -> i16 {
        if number <= HARD_FAULT { number as i16 - 4 } else { self.priority(number).into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Masks = Masks { primask: false, faultmask: false, basepri: 0 };
    const LOW: Number = 54;
    const HIGH: Number = 70;

    fn two() -> Exceptions {
        let mut exceptions = Exceptions::default();
        exceptions.set_priority(LOW, 0x10);
        exceptions.set_priority(HIGH, 0x00);
        for number in [LOW, HIGH] {
            exceptions.enable(number, true);
        }
        exceptions
    }

    #[test]
    fn the_higher_priority_comes_first_and_interrupts_the_lower() {
        let mut exceptions = two();
        exceptions.pend(LOW);
        assert_eq!(exceptions.next(OPEN), Some(LOW));
        exceptions.enter(LOW);
        exceptions.pend(LOW);
        assert_eq!(exceptions.next(OPEN), None, "it does not interrupt itself");
        exceptions.pend(HIGH);
        assert_eq!(exceptions.next(OPEN), Some(HIGH));
        exceptions.enter(HIGH);
        assert_eq!(exceptions.depth(), 2);
        exceptions.leave();
        exceptions.leave();
        assert_eq!(exceptions.next(OPEN), Some(LOW));
    }

    #[test]
    fn masks_hold_off_what_they_name() {
        let mut exceptions = two();
        let base = Masks { basepri: 0x10, ..OPEN };
        let all = Masks { primask: true, ..OPEN };
        exceptions.pend(LOW);
        assert_eq!(exceptions.next(base), None);
        assert_eq!(exceptions.next(all), None);
        assert!(exceptions.wakes(all));
        assert!(!exceptions.wakes(base));
        exceptions.pend(HIGH);
        assert_eq!(exceptions.next(base), Some(HIGH));
        assert_eq!(exceptions.next(all), None);
        exceptions.pend(HARD_FAULT);
        assert_eq!(exceptions.next(all), Some(HARD_FAULT));
    }

    #[test]
    fn a_line_that_stays_up_asks_again_and_one_that_fell_does_not() {
        let mut exceptions = two();
        exceptions.set_line(LOW, true);
        exceptions.enter(LOW);
        assert!(!exceptions.is_pending(LOW));
        exceptions.leave();
        assert_eq!(exceptions.next(OPEN), Some(LOW));
        exceptions.enter(LOW);
        exceptions.set_line(LOW, false);
        exceptions.leave();
        assert_eq!(exceptions.next(OPEN), None);
        // Down and up again while it is served: an edge that is not lost.
        exceptions.set_line(LOW, true);
        exceptions.enter(LOW);
        exceptions.set_line(LOW, false);
        exceptions.set_line(LOW, true);
        exceptions.set_line(LOW, false);
        exceptions.leave();
        assert_eq!(exceptions.next(OPEN), Some(LOW));
    }
}
