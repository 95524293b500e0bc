//! How formulas are written: numbers, names, functions, brackets and `+ - * / ^`.

use std::f64::consts::PI;
use std::fmt;

use super::Node;

/// Characters that a formula may have.
const MOST_CHARACTERS: usize = 1000;

/// Brackets, signs and powers that may lie within each other: reading is recursive.
const MOST_NESTED: usize = 100;

type One = fn(f64) -> f64;
type Two = fn(f64, f64) -> f64;

/// Functions of one number. None jumps: steps would pass over it.
const OF_ONE: [(&str, One); 13] = [
    ("sin", libm::sin),
    ("cos", libm::cos),
    ("tan", libm::tan),
    ("atan", libm::atan),
    ("sinh", libm::sinh),
    ("cosh", libm::cosh),
    ("tanh", libm::tanh),
    ("exp", libm::exp),
    ("ln", libm::log),
    ("sqrt", libm::sqrt),
    ("abs", libm::fabs),
    ("erf", libm::erf),
    ("erfc", libm::erfc),
];

/// Functions of two numbers.
const OF_TWO: [(&str, Two); 2] = [("min", libm::fmin), ("max", libm::fmax)];

/// What may stand where a value has to.
const VALUE: &str = "a number, a name, a function or \"(\"";

/// Why a text is no formula.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mistake {
    /// Column of what is wrong, in characters from 1.
    pub column: usize,
    /// What was found.
    pub found: String,
    /// What is allowed, as completes "must be ...".
    pub allowed: String,
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {} in column {}, must be {}", self.found, self.column, self.allowed)
    }
}

/// Reads a whole text.
pub(super) fn parse(text: &str, names: &[(&'static str, usize)]) -> Result<Node, Mistake> {
    let mut parser = Parser { characters: text.chars().collect(), next: 0, nested: 0, names };
    let length = parser.characters.len();
    if length > MOST_CHARACTERS {
        let (found, allowed) = (format!("{length} characters"), format!("at most {MOST_CHARACTERS}"));
        return Err(Mistake { column: MOST_CHARACTERS + 1, found, allowed });
    }
    let root = parser.sum()?;
    match parser.peek() {
        None => Ok(root),
        Some(_) => Err(parser.mistake("+, -, *, /, ^ or the end")),
    }
}

struct Parser<'a> {
    characters: Vec<char>,
    next: usize,
    nested: usize,
    names: &'a [(&'static str, usize)],
}

impl Parser<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.characters.get(self.next).is_some_and(|own| own.is_whitespace()) {
            self.next += 1;
        }
        self.characters.get(self.next).copied()
    }

    /// Passes over a character if it is the next one.
    fn take(&mut self, wanted: char) -> bool {
        let is_there = self.peek() == Some(wanted);
        self.next += usize::from(is_there);
        is_there
    }

    /// Passes over one of two operators if it is the next character.
    fn operator(&mut self, operators: [(char, Two); 2]) -> Option<Two> {
        operators.into_iter().find(|(own, _)| self.take(*own)).map(|(_, operator)| operator)
    }

    /// The end of characters of a kind from a place on.
    fn while_is(&self, from: usize, is: impl Fn(char) -> bool) -> usize {
        let more = self.characters.iter().skip(from).take_while(|own| is(**own)).count();
        from + more
    }

    fn text(&self, from: usize, to: usize) -> String {
        self.characters[from..to].iter().collect()
    }

    /// That something else is next than what is allowed.
    fn mistake(&mut self, allowed: impl Into<String>) -> Mistake {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(_) => {
                let end = self.while_is(self.next, is_of_name).max(self.next + 1);
                format!("\"{}\"", self.text(self.next, end))
            }
        };
        Mistake { column: self.next + 1, found, allowed: allowed.into() }
    }

    fn sum(&mut self) -> Result<Node, Mistake> {
        let mut sum = self.product()?;
        while let Some(operator) = self.operator([('+', |a, b| a + b), ('-', |a, b| a - b)]) {
            sum = Node::Two(operator, Box::new([sum, self.product()?]));
        }
        Ok(sum)
    }

    fn product(&mut self) -> Result<Node, Mistake> {
        let mut product = self.signed()?;
        while let Some(operator) = self.operator([('*', |a, b| a * b), ('/', |a, b| a / b)]) {
            product = Node::Two(operator, Box::new([product, self.signed()?]));
        }
        Ok(product)
    }

    /// A power with a sign before it: -x^2 is -(x^2).
    fn signed(&mut self) -> Result<Node, Mistake> {
        if self.nested == MOST_NESTED {
            return Err(self.mistake(format!("at most {MOST_NESTED} brackets, signs and powers within each other")));
        }
        self.nested += 1;
        let found = match self.peek() {
            Some('-') => {
                self.next += 1;
                self.signed().map(|value| Node::One(|a| -a, Box::new(value)))
            }
            Some('+') => {
                self.next += 1;
                self.signed()
            }
            _ => self.power(),
        };
        self.nested -= 1;
        found
    }

    /// A value with its exponent, which may have a sign and one of its own: 2^3^2 is 2^(3^2).
    fn power(&mut self) -> Result<Node, Mistake> {
        let base = self.value()?;
        if !self.take('^') {
            return Ok(base);
        }
        Ok(Node::Two(libm::pow, Box::new([base, self.signed()?])))
    }

    fn value(&mut self) -> Result<Node, Mistake> {
        match self.peek() {
            Some('(') => {
                self.next += 1;
                let value = self.sum()?;
                self.close()?;
                Ok(value)
            }
            Some(digit) if digit.is_ascii_digit() || digit == '.' => self.number(),
            Some(letter) if letter.is_alphabetic() => self.name(),
            _ => Err(self.mistake(VALUE)),
        }
    }

    fn close(&mut self) -> Result<(), Mistake> {
        if self.take(')') { Ok(()) } else { Err(self.mistake("+, -, *, /, ^ or \")\"")) }
    }

    fn number(&mut self) -> Result<Node, Mistake> {
        let digit = |own: char| own.is_ascii_digit();
        let mut end = self.while_is(self.next, |own| digit(own) || own == '.');
        if matches!(self.characters.get(end), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.characters.get(end + 1), Some('+' | '-')));
            end = self.while_is(end + 1 + sign, digit);
        }
        match self.text(self.next, end).parse() {
            Ok(number) => {
                self.next = end;
                Ok(Node::Number(number))
            }
            Err(_) => {
                let found = format!("\"{}\"", self.text(self.next, end));
                Err(Mistake { column: self.next + 1, found, allowed: "a number, as 0.5 or 2e-3".into() })
            }
        }
    }

    /// A coordinate, a constant or a function with its arguments.
    fn name(&mut self) -> Result<Node, Mistake> {
        let end = self.while_is(self.next, is_of_name);
        let name = self.text(self.next, end);
        if let Some((_, function)) = OF_ONE.iter().find(|(own, _)| *own == name) {
            self.next = end;
            self.open(&name)?;
            let argument = self.sum()?;
            self.close()?;
            return Ok(Node::One(*function, Box::new(argument)));
        }
        if let Some((_, function)) = OF_TWO.iter().find(|(own, _)| *own == name) {
            self.next = end;
            self.open(&name)?;
            let first = self.sum()?;
            if !self.take(',') {
                return Err(self.mistake(format!("\",\" and the second number of \"{name}\"")));
            }
            let second = self.sum()?;
            self.close()?;
            return Ok(Node::Two(*function, Box::new([first, second])));
        }
        let value = match self.names.iter().find(|(own, _)| *own == name) {
            Some((_, index)) => Node::Coordinate(*index),
            None if name == "pi" => Node::Number(PI),
            None => return Err(self.mistake(self.known())),
        };
        self.next = end;
        Ok(value)
    }

    fn open(&mut self, function: &str) -> Result<(), Mistake> {
        if self.take('(') { Ok(()) } else { Err(self.mistake(format!("\"(\" behind \"{function}\""))) }
    }

    /// All names that a formula may have, in words.
    fn known(&self) -> String {
        let quoted = |name: &str| format!("\"{name}\"");
        let names: Vec<String> = self.names.iter().map(|(name, _)| quoted(name)).collect();
        let functions = OF_ONE.iter().map(|(name, _)| *name).chain(OF_TWO.iter().map(|(name, _)| *name));
        let functions: Vec<&str> = functions.collect();
        format!("{}, \"pi\" or a function: {}", names.join(", "), functions.join(", "))
    }
}

/// Whether a character may stand in a name.
fn is_of_name(own: char) -> bool {
    own.is_alphanumeric() || own == '_'
}

#[cfg(test)]
mod tests {
    use crate::formula::{Formula, TIME, X, Y};

    const NAMES: [(&str, usize); 3] = [("x", X), ("y", Y), ("t", TIME)];

    fn value(text: &str) -> f64 {
        Formula::read(text, &NAMES).unwrap_or_else(|mistake| unreachable!("{text}: {mistake}")).at(&[0.5, 3.0, 7.0])
    }

    #[test]
    fn signs_powers_and_brackets_bind_as_on_paper() {
        for (text, expected) in [
            ("1 - 2 - 3", -4.0),
            ("8/4/2", 1.0),
            ("2 + 3*4", 14.0),
            ("(2 + 3)*4", 20.0),
            ("-y^2", -9.0),
            ("(-y)^2", 9.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("2*-y", -6.0),
            ("--y + +y", 6.0),
            (".5e1 + 1.5E-1*2", 5.3),
            ("x*y - t", -5.5),
            ("max(x, min(y, t))", 3.0),
            ("sqrt(abs(-16))", 4.0),
            ("ln(exp(2)) + erf(0) + erfc(0)", 3.0),
            ("cosh(0) + sinh(0) + tanh(0) + atan(0) + tan(0)", 1.0),
            (" cos ( pi ) ", -1.0),
            ("sin(pi/6)^2 + cos(pi/6)^2", 1.0),
        ] {
            assert!((value(text) - expected).abs() < 1e-15 * expected.abs().max(1.0), "{text}: {}", value(text));
        }
        let formula = Formula::read("10 + 5*cos(pi*y/2)", &NAMES).expect("a formula");
        assert_eq!([X, Y, TIME].map(|index| formula.uses(index)), [false, true, false]);
    }

    #[test]
    fn mistakes_are_found_in_their_columns() {
        for (text, column, words) in [
            ("", 1, "found the end in column 1, must be a number, a name, a function or \"(\""),
            ("2x", 2, "found \"x\" in column 2, must be +, -, *, /, ^ or the end"),
            ("10 + 5*foo(x)", 8, "found \"foo\" in column 8, must be \"x\", \"y\", \"t\", \"pi\" or a function: sin"),
            ("cos x", 5, "found \"x\" in column 5, must be \"(\" behind \"cos\""),
            ("(1 + 2", 7, "found the end in column 7, must be +, -, *, /, ^ or \")\""),
            ("1 + 2)", 6, "found \")\" in column 6"),
            ("3 ** 2", 4, "found \"*\" in column 4"),
            ("max(x)", 6, "found \")\" in column 6, must be \",\""),
            ("1.2.3", 1, "found \"1.2.3\" in column 1, must be a number"),
            ("2e", 1, "found \"2e\" in column 1, must be a number"),
            ("x = 3", 3, "found \"=\" in column 3"),
            ("é", 1, "found \"é\" in column 1"),
        ] {
            let mistake = Formula::read(text, &NAMES).expect_err(text);
            assert_eq!(mistake.column, column, "{text}: {mistake}");
            assert!(mistake.to_string().contains(words), "{text}: {mistake}");
        }
    }

    /// Nothing that a file holds ends the program.
    #[test]
    fn long_and_deep_texts_are_refused() {
        for text in ["(".repeat(1000), "-".repeat(1000), "x^".repeat(500), "sin(".repeat(250)] {
            let mistake = Formula::read(&text, &NAMES).expect_err("too deep").to_string();
            assert!(mistake.contains("at most 100 brackets"), "{mistake}");
        }
        let long = "x+".repeat(500);
        assert!(Formula::read(&format!("{long}x"), &NAMES).expect_err("too long").to_string().contains("1001 char"));
        assert_eq!(value(&long[..999]), 0.5 * 500.0);
    }
}
