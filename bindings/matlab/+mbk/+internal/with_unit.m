function text = with_unit(text, unit)
% 'force (N)'; without a unit the text alone.
  if ~isempty(unit)
    text = [text ' (' unit ')'];
  end
end
