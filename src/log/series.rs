//! Series: topics whose messages are JSON objects of numbers and words, with a schema that gives the units.

/// Names a series of the [`LogWriter`](super::LogWriter) that handed it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SeriesId(pub(super) usize);

/// One property of the messages of a series, next to `time`, which every series has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field<'a> {
    name: &'a str,
    /// Unit of a number; `None` marks a text.
    unit: Option<&'a str>,
    description: &'a str,
}

impl<'a> Field<'a> {
    /// A number. `name` is its JSON key, `unit` its SI unit as it is to be shown ("m/s", "Pa"; "1" when it has
    /// none), `description` what it means.
    pub const fn number(name: &'a str, unit: &'a str, description: &'a str) -> Self {
        Self { name, unit: Some(unit), description }
    }

    /// A word or a sentence, such as what limited a time step. `name` is its JSON key.
    pub const fn text(name: &'a str, description: &'a str) -> Self {
        Self { name, unit: None, description }
    }
}

/// One value of a record, for the field at the same place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// A number in the unit of its field. Infinities and NaN are written as `null`, for JSON has no others.
    Number(f64),
    /// A text.
    Text(&'a str),
}

/// A series as the writer keeps it.
#[derive(Debug)]
pub(super) struct Series {
    pub channel: u16,
    pub sequence: u32,
    columns: Vec<SeriesColumn>,
}

#[derive(Debug)]
struct SeriesColumn {
    /// The key as it stands in every message: `,"name":`.
    key: Vec<u8>,
    is_text: bool,
}

impl Series {
    pub fn new(channel: u16, fields: &[Field]) -> serde_json::Result<Self> {
        let mut columns = Vec::with_capacity(fields.len());
        for field in fields {
            let mut key = vec![b','];
            push_text(&mut key, field.name)?;
            key.push(b':');
            columns.push(SeriesColumn { key, is_text: field.unit.is_none() });
        }
        Ok(Self { channel, sequence: 0, columns })
    }

    /// Whether the values are as many as the fields, and each of its field's kind.
    pub fn fits<'v>(&self, values: impl Iterator<Item = Value<'v>>) -> bool {
        let given = values.map(|value| matches!(value, Value::Text(_)));
        given.eq(self.columns.iter().map(|column| column.is_text))
    }

    /// Appends one message to `json`: the time in seconds, then the values in the order of the fields.
    pub fn encode<'v>(
        &self,
        json: &mut Vec<u8>,
        time: f64,
        values: impl Iterator<Item = Value<'v>>,
    ) -> serde_json::Result<()> {
        json.extend_from_slice(b"{\"time\":");
        push_number(json, time)?;
        for (column, value) in self.columns.iter().zip(values) {
            json.extend_from_slice(&column.key);
            match value {
                Value::Number(number) => push_number(json, number)?,
                Value::Text(text) => push_text(json, text)?,
            }
        }
        json.push(b'}');
        Ok(())
    }
}

/// The JSON schema of a series. It is put together by hand because a map of `serde_json` would sort the
/// properties, and players list them in the order of the schema.
///
/// A number that can be `null` is still of type "number" here: viewers refuse a list of types.
pub(super) fn schema(title: &str, description: &str, fields: &[Field]) -> serde_json::Result<Vec<u8>> {
    const TIME: Field = Field::number("time", "s", "simulated time");
    let all = || std::iter::once(&TIME).chain(fields);
    let mut json = b"{\"title\":".to_vec();
    push_text(&mut json, title)?;
    json.extend_from_slice(b",\"description\":");
    push_text(&mut json, description)?;
    json.extend_from_slice(b",\"type\":\"object\",\"properties\":");
    push_list(&mut json, b"{}", all(), push_property)?;
    json.extend_from_slice(b",\"required\":");
    push_list(&mut json, b"[]", all(), |json, field| push_text(json, field.name))?;
    json.push(b'}');
    Ok(json)
}

/// Names of the properties that [`schema`] describes, in its order, and the units of those that are numbers.
pub(crate) fn described_fields(schema: &[u8]) -> Vec<(String, Option<String>)> {
    let schema: serde_json::Value = serde_json::from_slice(schema).unwrap_or_default();
    let names = schema["required"].as_array().into_iter().flatten().filter_map(serde_json::Value::as_str);
    let unit = |name: &str| {
        let property = &schema["properties"][name];
        let description = property["description"].as_str().unwrap_or_default();
        let unit = description.strip_suffix(']').and_then(|text| text.rsplit_once('['));
        (property["type"] == "number").then(|| unit.map_or_else(String::new, |(_, unit)| unit.to_owned()))
    };
    names.map(|name| (name.to_owned(), unit(name))).collect()
}

fn push_property(json: &mut Vec<u8>, field: &Field) -> serde_json::Result<()> {
    push_text(json, field.name)?;
    match field.unit {
        Some(unit) => {
            json.extend_from_slice(b":{\"type\":\"number\",\"description\":");
            push_text(json, &format!("{} [{unit}]", field.description))?;
        }
        None => {
            json.extend_from_slice(b":{\"type\":\"string\",\"description\":");
            push_text(json, field.description)?;
        }
    }
    json.push(b'}');
    Ok(())
}

fn push_list<'f, 'a: 'f>(
    json: &mut Vec<u8>,
    brackets: &[u8; 2],
    fields: impl Iterator<Item = &'f Field<'a>>,
    push: impl Fn(&mut Vec<u8>, &Field) -> serde_json::Result<()>,
) -> serde_json::Result<()> {
    json.push(brackets[0]);
    for (place, field) in fields.enumerate() {
        if place > 0 {
            json.push(b',');
        }
        push(json, field)?;
    }
    json.push(brackets[1]);
    Ok(())
}

fn push_text(json: &mut Vec<u8>, text: &str) -> serde_json::Result<()> {
    serde_json::to_writer(json, text)
}

/// The shortest digits that read back as the same number; `null` for infinities and NaN.
fn push_number(json: &mut Vec<u8>, number: f64) -> serde_json::Result<()> {
    serde_json::to_writer(json, &number)
}
