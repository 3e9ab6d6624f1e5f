function unit = unit_of(document, name)
% Unit of 'M', 'B', 'K', 'x0' or 'force'; '' if the document has no units.
  unit = '';
  if isfield(document, 'units')
    unit = document.units.(name);
  end
end
