# escape.awk - text as HTML.
{ print html($0) }
