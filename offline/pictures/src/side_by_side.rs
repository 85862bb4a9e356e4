//! Two halves of an offline tool's work side by side, where the system has threads (a browser's
//! page has none).

/// Both results; the first is found on another thread where there is one.
pub(crate) fn both<A: Send, B>(first: impl Fn() -> A + Sync, second: impl FnOnce() -> B) -> (A, B) {
    std::thread::scope(|scope| {
        let beside = std::thread::Builder::new().spawn_scoped(scope, &first);
        let second = second();
        let first = match beside {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Err(_) => first(),
        };
        (first, second)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_done_and_see_what_was_there_before() {
        let numbers = [3, 4];
        assert_eq!(both(|| numbers[0] * 2, || numbers[1] * 2), (6, 8));
    }

    #[test]
    #[should_panic(expected = "as it was")]
    fn a_panic_arrives_as_it_was() {
        both(|| panic!("as it was"), || ());
    }
}
