use super::*;

static COMPARISON: Comparison = Comparison {
    name: "test",
    title: "A test",
    cost: Axis::new("time", "time (s)"),
    errors: &[
        Axis::new("error", "error (1)").floored(1e-9, "rounding"),
        Axis::new("open", "open (1)"),
    ],
    others: &["steps"],
    kept: b"",
};

fn table(rows: &[(&str, f64, f64, f64)]) -> Tradeoff {
    let row = |&(name, time, error, open): &(&str, f64, f64, f64)| {
        Method::new("a case", "a family", name, [time, error, open, 1.0])
    };
    Tradeoff { comparison: &COMPARISON, methods: rows.iter().map(row).collect() }
}

fn names<'t>(front: &[&'t Method]) -> Vec<&'t str> {
    front.iter().map(|method| &*method.name).collect()
}

#[test]
fn the_front_holds_what_nothing_beats() {
    let all = table(&[
        ("dear", 9.0, 1e-12, 5.0),
        ("beaten", 3.0, 0.2, 1.0),
        ("cheap", 1.0, 0.5, 1.0),
        ("fair", 2.0, 0.1, 2.0),
        ("as good below the floor", 8.0, 1e-10, 9.0),
        ("fails", 0.1, f64::INFINITY, 0.5),
    ]);
    let front = all.front("a case", 0);
    assert_eq!(names(&front), ["cheap", "fair", "as good below the floor"]);
    assert_eq!(names(&all.front("a case", 1)), ["fails"]);
    assert!(all.front("another case", 0).is_empty());
}

/// A name with a comma, a number that is infinite, and a figure that the method does not have.
#[test]
fn a_table_is_written_as_it_was_read() {
    let text = "case,family,name,time,error,open,steps\na,b,\"c, d\",1.23457e-7,inf,,0\n";
    let mut file = Vec::new();
    let table = Table::new("kept.csv", text.as_bytes()).unwrap();
    Tradeoff::read(&COMPARISON, table).unwrap().write(&mut file).unwrap();
    assert_eq!(String::from_utf8(file).unwrap(), text);
}

#[test]
fn what_is_no_such_table_is_refused() {
    for (text, said) in [
        ("case,family,name,time,error\na,b,c,1,1\n", "there is no column `open`"),
        ("case,family,name,time,error,open,steps\n", "too few"),
        ("case,family,name,time,error,open,steps\na,b,c,-1,1,1,1\n", "0 or more"),
        ("case,family,name,time,error,open,steps\na,b,c,1,NaN,1,1\n", "0 or more"),
    ] {
        let table = Table::new("kept.csv", text.as_bytes()).unwrap();
        let error = Tradeoff::read(&COMPARISON, table).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}
