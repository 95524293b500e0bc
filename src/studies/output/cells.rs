//! CSV that no program for tables takes for more than texts and numbers.

use std::io::{self, Write};

/// A writer of CSV in whose texts an apostrophe stands before what would begin a formula; numbers stay as they are.
pub fn writer<W: Write>(out: W) -> csv::Writer<Plain<W>> {
    csv::Writer::from_writer(Plain { out, cell: Vec::new(), quoted: false })
}

/// What passes cells on.
pub struct Plain<W: Write> {
    out: W,
    /// The cell at hand, as it is written.
    cell: Vec<u8>,
    /// Whether separators belong to it.
    quoted: bool,
}

impl<W: Write> Plain<W> {
    fn pass(&mut self) -> io::Result<()> {
        let quotes = usize::from(self.cell.first() == Some(&b'"'));
        let begins = self.cell.get(quotes).is_some_and(|first| b"=+-@\t\r\n".contains(first));
        let is_number = || str::from_utf8(&self.cell).is_ok_and(|cell| cell.parse::<f64>().is_ok());
        if begins && !is_number() {
            self.cell.insert(quotes, b'\'');
        }
        self.out.write_all(&self.cell)?;
        self.cell.clear();
        Ok(())
    }
}

impl<W: Write> Write for Plain<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            // A quote within a quoted cell is written twice, which leaves it quoted.
            self.quoted ^= *byte == b'"';
            if !self.quoted && b",\n".contains(byte) {
                self.pass()?;
                self.out.write_all(&[*byte])?;
            } else {
                self.cell.push(*byte);
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn written(rows: &[Vec<String>]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut csv = csv::WriterBuilder::new().flexible(true).from_writer(Plain {
            out: &mut out,
            cell: Vec::new(),
            quoted: false,
        });
        rows.iter().for_each(|row| csv.write_record(row).expect("written"));
        csv.flush().expect("written");
        drop(csv);
        out
    }

    #[test]
    fn formulas_are_texts_and_numbers_stay() {
        let cell = |text: &str| String::from_utf8(written(&[vec![text.to_owned(), "x".into()]])).expect("text");
        assert_eq!(cell("=1+1"), "'=1+1,x\n");
        assert_eq!(cell("=HYPERLINK(\"a\",\"b\")"), "\"'=HYPERLINK(\"\"a\"\",\"\"b\"\")\",x\n");
        for text in ["+1-2", "-1+2", "@SUM(A1)", "\tx"] {
            assert_eq!(cell(text), format!("'{text},x\n"));
        }
        for text in ["-1.5", "+2e-3", "-inf", "-1e300", "a=b", "1-2", "'=1"] {
            assert_eq!(cell(text), format!("{text},x\n"));
        }
    }

    proptest! {
        #[test]
        fn every_text_is_read_back_with_at_most_an_apostrophe(
            rows in prop::collection::vec(prop::collection::vec("[-=+@a1,\"\\n\\r\\t' é]{0,6}", 1..4), 1..4),
        ) {
            let text = written(&rows);
            let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(&text[..]);
            let read: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("CSV");
            prop_assert_eq!(read.len(), rows.len());
            for (found, row) in read.iter().zip(&rows) {
                prop_assert_eq!(found.len(), row.len());
                for (found, wanted) in found.iter().zip(row) {
                    prop_assert!(found == wanted || found.strip_prefix('\'') == Some(wanted));
                    let begins = found.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
                    prop_assert!(!begins || found.parse::<f64>().is_ok(), "{:?}", found);
                }
            }
        }
    }
}
