//! Lines of stored results: words that read back to the same bits.

use runs::number;
use std::str::Split;

/// What is one word of a line.
pub(super) trait Word {
    /// The word.
    fn write(&self) -> String;
    /// Reads it back; `None` for anything else, and for numbers that are not finite.
    fn read(word: &str) -> Option<Self>
    where
        Self: Sized;
}

impl Word for f64 {
    fn write(&self) -> String {
        number(*self)
    }

    fn read(word: &str) -> Option<Self> {
        word.parse().ok().filter(|v: &f64| v.is_finite())
    }
}

impl Word for usize {
    fn write(&self) -> String {
        self.to_string()
    }

    fn read(word: &str) -> Option<Self> {
        word.parse().ok()
    }
}

impl Word for u64 {
    fn write(&self) -> String {
        self.to_string()
    }

    fn read(word: &str) -> Option<Self> {
        word.parse().ok()
    }
}

impl Word for bool {
    fn write(&self) -> String {
        self.to_string()
    }

    fn read(word: &str) -> Option<Self> {
        word.parse().ok()
    }
}

impl Word for String {
    fn write(&self) -> String {
        self.clone()
    }

    fn read(word: &str) -> Option<Self> {
        (!word.is_empty()).then(|| word.to_owned())
    }
}

/// Absent is a dash.
impl<T: Word> Word for Option<T> {
    fn write(&self) -> String {
        self.as_ref().map_or_else(|| "-".to_owned(), Word::write)
    }

    fn read(word: &str) -> Option<Self> {
        if word == "-" { Some(None) } else { T::read(word).map(Some) }
    }
}

/// A line of words, with its end.
pub(super) fn line(words: &[&dyn Word]) -> String {
    words.iter().map(|word| word.write()).collect::<Vec<_>>().join(" ") + "\n"
}

/// The words of a line, from the left.
pub(super) struct Words<'a>(Split<'a, char>);

impl<'a> Words<'a> {
    pub fn of(line: &'a str) -> Self {
        Self(line.split(' '))
    }

    /// The next word, as what it is to be.
    pub fn word<T: Word>(&mut self) -> Option<T> {
        T::read(self.0.next()?)
    }

    /// Nothing where there are no more words, `None` where there are.
    pub fn end(mut self) -> Option<()> {
        self.0.next().is_none().then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_read_back_to_the_same_bits() {
        let text =
            line(&[&(0.1 + 0.2), &-0.0, &5e-324, &None::<f64>, &7_usize, &true, &"converged".to_owned()]);
        assert_eq!(text, "0.30000000000000004 -0.0 5e-324 - 7 true converged\n");
        let mut words = Words::of(text.trim_end());
        let numbers = [(); 3].map(|()| words.word::<f64>().unwrap().to_bits());
        assert_eq!(numbers, [0.1 + 0.2, -0.0, 5e-324].map(f64::to_bits));
        assert_eq!(words.word::<Option<u64>>(), Some(None));
        assert_eq!(words.word::<Option<usize>>(), Some(Some(7)));
        assert_eq!((words.word::<bool>(), words.word::<String>()), (Some(true), Some("converged".into())));
        assert_eq!(words.end(), Some(()));
        for bad in ["NaN", "inf", "1e999", "", "x"] {
            assert_eq!(f64::read(bad), None, "{bad}");
            assert_eq!(<Option<f64>>::read(bad), None, "{bad}");
        }
        assert_eq!((Words::of("1 2").end(), usize::read("-1"), u64::read("1.0")), (None, None, None));
    }
}
